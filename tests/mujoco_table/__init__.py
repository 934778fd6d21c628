"""A foreign table: a puck in MuJoCo, whose laws of contact nobody here wrote.

    make_recording(Path("out/tilted"), CASES["tilt"], seed=1, seconds=60.0)

`model` builds the table, `launches` lets the puck go and records it, `cases` says what each table has that the
simulator's baseline leaves out.
"""

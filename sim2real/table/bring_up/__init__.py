"""The bring-up of a table, step by step: each passes, or says what to mend.

- `rig`: a connected table with what the steps share; `steps`: the steps, in order; `run`: goes through them.
"""

"""The checks behind `puckpilot_env.check`: a file a subject, each with a table `CHECKS`; `runner` lists the files."""

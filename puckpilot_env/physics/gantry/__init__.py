"""The mallet's gantry: plans of switched voltages, and its motion in closed form."""

"""Forces on a gliding puck that no listed effect says: smooth ones, and those whose place or time is searched."""

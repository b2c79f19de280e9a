"""Studies of one deck: what accuracy costs, and what each effect changes."""

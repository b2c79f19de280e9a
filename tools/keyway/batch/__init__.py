"""Many runs: decks, or a template deck with a table of values, here, on Slurm or on Dask."""

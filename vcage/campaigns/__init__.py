"""Many runs by one plan: cells, jobs, their drivers, and what has come of them."""

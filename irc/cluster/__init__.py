"""From a task and a Dask scheduler to the best answer of a race of the cluster's workers."""

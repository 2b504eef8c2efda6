"""Many simulations: configuration, store, MPI ranks, and the table that they become."""

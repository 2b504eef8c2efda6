"""From the records of runs to w_appr, w_retr, k and their uncertainties, on plain arrays."""

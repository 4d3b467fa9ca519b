"""Recording: a bound mechanism run once on numbers that note what is done with them."""

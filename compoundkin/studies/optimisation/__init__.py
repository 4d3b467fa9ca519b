"""Better dimensions: from many starts at once to verified mechanisms, and how sure one can be of them."""

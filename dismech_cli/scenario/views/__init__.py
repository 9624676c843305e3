"""A validated scenario seen otherwise: walked, dumped, traced, documented."""

"""Types of single values: quantities, laws, selections."""

"""How hard things press and rub: formulas of one gap, and what they need to know."""

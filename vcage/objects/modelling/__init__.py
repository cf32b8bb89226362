"""What models are made with: solids, convex pieces, texture mappings, painted surfaces, and the record they end in."""

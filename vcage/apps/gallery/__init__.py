"""Pictures of assets for people: from three sides and from above, at one scale, and the page that shows them all."""

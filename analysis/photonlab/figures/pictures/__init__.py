"""Figures that show pictures: of scenes, of radii, of what emission has learnt."""

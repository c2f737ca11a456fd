"""Draws what `photonlab run` recorded. How to call it and how to read what it draws: README.md."""

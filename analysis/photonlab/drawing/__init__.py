"""What figures share: their looks, pictures on a screen, and files."""

"""Rows of docs/replications/README.md, made again from records: which runs a row needs, its numbers by code, and its verdict."""

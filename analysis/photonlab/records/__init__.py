"""What a results folder holds, read and checked: tables, runs, references, images, sums over seeds."""

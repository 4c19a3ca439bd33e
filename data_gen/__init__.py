"""What the algorithm learns from and is tested on: homes, views of them, and where to start."""

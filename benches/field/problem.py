class Problem(Exception):
    """Something that ends the experiment and is told without a traceback: what is wrong, and where."""

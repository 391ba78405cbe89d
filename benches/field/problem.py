class Problem(Exception):
    """An error that ends the experiment and is reported without a traceback: its cause and its location."""

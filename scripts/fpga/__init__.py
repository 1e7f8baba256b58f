"""Tools of hardware that scripts share: programs that are got, run, and asked for figures."""

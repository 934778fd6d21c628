"""The diagnosis as one self-contained page: words, tables and pictures, without a network."""

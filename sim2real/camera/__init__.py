"""Pictures with their times: cameras, files and a renderer behind one small interface, and a watch beside them."""

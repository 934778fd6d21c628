"""A trained policy: its file, and the player that plays it without torch.

`policy` reads and writes the file and makes a `PolicyPlayer` of it. The player's path: observation -> `decoder`, where
the variant shows camera frames alone -> `scaling` -> `network` -> action. `onnx_file` writes a policy for other
programs; `mean_policy` averages the weights of several.
"""

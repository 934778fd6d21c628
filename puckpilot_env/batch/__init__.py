"""The machinery behind `puckpilot_env.tables`: batched kernels, threads, snapshots, traces."""

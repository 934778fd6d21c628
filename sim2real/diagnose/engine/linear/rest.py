"""Residuals beside columns that are known, and how much of them further columns explain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class Rest:
    """Residuals `r` (n,) minus their projection on known columns, which span the orthonormal `basis` (n, k)."""

    basis: np.ndarray
    r: np.ndarray

    @classmethod
    def of(cls, r: np.ndarray, known: np.ndarray) -> Rest:
        """Project the columns `known` (n, k) out of the residuals `r` (n,)."""
        basis = np.linalg.qr(known / np.maximum(np.linalg.norm(known, axis=0), 1e-300))[0]
        return cls(basis, r - basis @ (basis.T @ r))

    def gains(self, block: np.ndarray) -> np.ndarray:
        """The decrease (k,) of the sum of squares by each column of `block` (n, k) in addition to the known ones."""
        alone = block - self.basis @ (self.basis.T @ block)
        size = np.einsum("ik,ik->k", alone, alone)
        return np.where(size > 1e-9, (alone.T @ self.r) ** 2 / np.maximum(size, 1e-9), 0.0)

    def normal(self, block: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The normal matrix (k, k) of the columns of `block` (n, k) beside the known ones, and its right side (k,)."""
        shared = self.basis.T @ block
        return block.T @ block - shared.T @ shared, block.T @ self.r


def gains_of_groups(normal: np.ndarray, right: np.ndarray) -> np.ndarray:
    """The decrease (w,) of the sum of squares by each of w groups of q columns, from their normal matrices (w, q, q)
    and right sides (w, q)."""
    size = np.einsum("wqq->w", normal)
    ridge = 1e-9 * np.maximum(size, 1e-9)[:, None, None] * np.eye(normal.shape[1])
    return np.einsum("wq,wq->w", right, np.linalg.solve(normal + ridge, right[:, :, None])[:, :, 0])

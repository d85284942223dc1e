"""Neighbours that torch looks up are NumPy's, whatever precision its user has chosen elsewhere."""

from contextlib import nullcontext

import numpy as np
import pytest

from oodscen.encoders._similarity import nearest as plain_nearest
from oodscen.metrics._vectors.accelerated import nearest

torch = pytest.importorskip("torch")


@pytest.fixture
def tf32():
    matmul = torch.backends.cuda.matmul
    if not hasattr(matmul, "fp32_precision"):
        pytest.skip("this torch has one name for the setting")
    before = matmul.fp32_precision
    matmul.fp32_precision = "tf32"
    yield
    assert matmul.fp32_precision == "tf32"
    matmul.fp32_precision = before


def check(context):
    rng = np.random.default_rng(0)
    queries, references = (rng.standard_normal((n, 64)).astype(np.float32) for n in (20, 300))
    queries, references = (
        v / np.linalg.norm(v, axis=1, keepdims=True) for v in (queries, references)
    )
    with context:
        found = nearest(queries, references, "cpu")
    np.testing.assert_allclose(found.cosine, plain_nearest(queries, references).cosine, atol=1e-6)


def test_another_precision_of_cuda_is_kept_and_not_used(tf32):
    check(nullcontext())


def test_lower_precision_around_the_search_is_not_used():
    check(torch.autocast("cpu", dtype=torch.bfloat16))

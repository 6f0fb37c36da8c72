import numpy as np
import pytest
from scipy import special, stats

from arena_kernels.random import _middle_quantile, _tail_quantile, fill_normals, normal, philox, uniform

KEY = np.uint64(0x9E3779B97F4A7C15)


@pytest.mark.parametrize(
    ("counter", "key", "words"),
    [  # philox4x32-10 of the known answers that its authors publish with Random123
        ((0, 0, 0, 0), (0, 0), (0x6627E8D5, 0xE169C58D, 0xBC57AC4C, 0x9B00DBD8)),
        ((0xFFFFFFFF,) * 4, (0xFFFFFFFF,) * 2, (0x408F276D, 0x41C83B0E, 0xA20BC7C6, 0x6D5451FD)),
        (
            (0x243F6A88, 0x85A308D3, 0x13198A2E, 0x03707344),
            (0xA4093822, 0x299F31D0),
            (0xD16CFE09, 0x94FDCCEB, 0x5001E420, 0x24126EA1),
        ),
    ],
)
def test_philox_gives_the_published_words(counter, key, words):
    assert philox(*counter, *key) == words


def test_uniform_numbers_are_uniform():
    sample = np.array([uniform(KEY, 7, i) for i in range(4000)])
    assert sample.min() >= 0.0
    assert sample.max() < 1.0
    assert stats.kstest(sample, "uniform").pvalue > 0.01


def test_normal_numbers_are_normal():
    sample = np.empty(20_000)
    fill_normals(KEY, 3, sample)
    assert stats.kstest(sample, "norm").pvalue > 0.01
    assert abs(np.corrcoef(sample[::2], sample[1::2])[0, 1]) < 0.03


def test_quantiles_are_those_of_the_normal_distribution():
    shares = np.concatenate((np.linspace(-0.4999, 0.4999, 2001), -0.5 + 0.1 ** np.arange(5.0, 14.0)))
    quantiles = [_middle_quantile(q) if abs(q) <= 0.425 else _tail_quantile(q) for q in shares.tolist()]
    np.testing.assert_allclose(quantiles, special.ndtri(0.5 + shares), rtol=1e-9, atol=1e-12)
    assert _tail_quantile(-0.5 + 2.0**-53) == pytest.approx(special.ndtri(2.0**-53), rel=1e-12)


@pytest.mark.parametrize("length", [0, 1, 4, 5])
def test_filling_an_array_gives_the_single_numbers(length):
    sample = np.empty(length)
    fill_normals(KEY, 11, sample)
    assert sample.tolist() == [normal(KEY, 11, i) for i in range(length)]


def test_every_part_of_the_counter_and_the_key_matters():
    numbers = [
        uniform(KEY, 1, 2),
        uniform(KEY, 2, 1),
        uniform(KEY, 1, 3),
        uniform(KEY + np.uint64(1), 1, 2),
        uniform(KEY, 1 + 2**32, 2),
    ]
    assert len(set(numbers)) == len(numbers)

"""Prints the golden numbers of test_image_measures.cpp. Needs scikit-image (made with 0.19.3)."""
import numpy as np
from skimage.metrics import structural_similarity


def image(height, width, seed):
    y, x = np.mgrid[0:height, 0:width].astype(np.int64)
    n = x * 7919 + y * 104729 + seed * 1299709
    n = n * (n % 1009 + 31) % 65536
    smooth = 0.5 + 0.3 * np.sin(0.13 * x + seed) * np.cos(0.07 * y)
    return np.clip(smooth + 0.2 * (n / 65536 - 0.5), 0, 1)


for height, width in [(48, 64), (11, 11), (37, 29)]:
    a, b = image(height, width, 1), image(height, width, 2)
    for name, other in [("unlike", b), ("gain", np.clip(0.8 * a + 0.15, 0, 1)),
                        ("noise", np.clip(a + 0.1 * (b - 0.5), 0, 1))]:
        print(height, width, name, structural_similarity(
            a, other, gaussian_weights=True, sigma=1.5, use_sample_covariance=False,
            data_range=1.0))

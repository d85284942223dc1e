"""A study as a data set: Parquet with a card for the Hugging Face Hub, and the same for other harnesses."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)

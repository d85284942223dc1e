from ._cached import CachedEncoder as CachedEncoder

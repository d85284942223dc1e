from ._check import extract_claims as extract_claims
from ._checking import check_claims as check_claims

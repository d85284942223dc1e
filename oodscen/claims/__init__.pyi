from ._checking import check_claims as check_claims
from ._faithfulness import extract_claims as extract_claims

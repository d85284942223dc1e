from ._faithfulness import extract_claims as extract_claims

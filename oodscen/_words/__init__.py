"""Text from outside: cleaning, rules, credentials, numbers as text."""

"""What a user writes: links, pairs, drives with laws, profiles. The mechanism made of them, and its validation."""

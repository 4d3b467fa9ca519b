"""What a user writes: links, pairs, drives with laws, profiles; the mechanism made of them, and its validation."""

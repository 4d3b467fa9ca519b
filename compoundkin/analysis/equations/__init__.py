"""Vector-loop equations as data: each term a length and an angle; their derivatives; and written out."""

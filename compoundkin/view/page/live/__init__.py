"""Live pages: what the browser needs to solve, draw and tell a mechanism anew when its dimensions change."""

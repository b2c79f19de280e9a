"""Recorded ground motions: files of networks and of users, and what is done to them."""

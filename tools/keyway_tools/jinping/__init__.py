"""The decks of the Jinping dam of Xu, Chen, Li and Yue (2014)."""

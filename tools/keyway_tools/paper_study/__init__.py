"""The two dams of Xu, Chen, Li and Yue (2014): all cases, and one page beside the paper."""

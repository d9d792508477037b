"""Where maps live: notebooks, sites and their builders; each is a thin layer over ``export``."""

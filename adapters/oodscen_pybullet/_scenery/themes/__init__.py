"""The roadside objects of each kind of land."""

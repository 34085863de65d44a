"""Recordings: arrays in memory, rosbag2 folders on disk."""

"""What a user writes: vehicles and missions."""

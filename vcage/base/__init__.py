"""What everything stands on: errors, files, geometry, pictures, videos, and work in processes."""

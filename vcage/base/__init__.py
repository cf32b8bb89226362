"""The base of all packages: errors, files, geometry, pictures, videos, and work in processes."""

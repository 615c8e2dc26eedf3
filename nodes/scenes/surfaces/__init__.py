"""What the scenes' surfaces are made of, and how bright that makes them."""

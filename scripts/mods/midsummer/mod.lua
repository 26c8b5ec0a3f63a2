return { name = "midsummer", version = "1.0" }
